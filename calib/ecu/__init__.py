"""The estimator of the table as C for an ECU, and what it is proved against."""
