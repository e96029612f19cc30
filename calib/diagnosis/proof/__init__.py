"""The proof on the hold-outs, and what is left unexplained."""
