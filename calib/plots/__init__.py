"""Figures: records in, matplotlib figures out. Nothing is shown on a screen."""
