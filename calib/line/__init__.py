"""The end of the line: station, fleet and gauge."""
