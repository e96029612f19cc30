"""Tables made of tables: the mean of several cars, and a table that a person corrected."""
