"""Named effects, a file for each link of the chain, and their catalogue."""
