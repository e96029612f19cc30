"""The car driven forward, and logs driven again."""
