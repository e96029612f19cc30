"""Gauge study of the calibration: scatter from repeat, station and car."""
