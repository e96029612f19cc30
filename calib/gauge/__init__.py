"""Is the calibration a good gauge: repeat, station and car."""
