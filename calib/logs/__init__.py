"""Read and write logs of many file formats."""
