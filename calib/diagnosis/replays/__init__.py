"""The hold-outs replayed open loop, the gap that is left, and what of it lasts."""
