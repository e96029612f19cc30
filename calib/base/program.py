"""Name and version of the program, as every document, table and log of a line has them."""

NAME = "brake-cal"
VERSION = "0.1.0"
PROGRAM = f"{NAME} {VERSION}"
