"""Propose a channel map for a foreign log from names, units and physics."""
