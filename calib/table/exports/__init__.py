"""What ECU tools and other programs read: a table in the formats of the field, and back again."""
