"""Where tables are kept: versions, their states and signatures, and the journal of all of it."""
