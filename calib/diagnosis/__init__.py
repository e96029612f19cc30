"""Where simulation and measurement disagree: find it, name it, add it, show the gap shrink."""
