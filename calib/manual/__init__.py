"""The manual: its pages beside this file, read as text and written as a linked site."""
