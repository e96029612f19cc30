"""A vehicle file for people: written with comments, judged as a car, and what follows from it."""
