"""Effects that the plant can have and a model may lack, as physics; nothing here knows the candidate terms."""
