"""One car at the end of the line: its verdict and its report."""
