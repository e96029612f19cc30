"""Rules that name the sensor, the part or the entry of the file that is likely wrong."""
