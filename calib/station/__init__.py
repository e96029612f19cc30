"""The end of the line: one car, one verdict, one report."""
