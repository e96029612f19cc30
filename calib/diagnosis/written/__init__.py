"""A diagnosis as it is written down: document, words, folder."""
