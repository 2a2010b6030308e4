"""A stranger's log becomes run files: a mapping is proposed with reasons, read by a person, and carried out."""
