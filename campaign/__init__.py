"""Long campaigns whose tables are committed under docs/."""
