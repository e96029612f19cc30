"""Numbers of the normal distribution that intervals and robust scales are made with, each once."""

Z95 = 1.96
"""Half width of a 95 % interval over sigma, the 0.975 quantile (1.959964) to the two decimals of
every textbook. Bands of stored tables are made with it: more digits would move each of them."""

QUARTILE = 0.6745
"""Upper quartile over sigma: the median of |x| of noise is this many sigma. Four digits, as the
outputs were made with."""

NINETY = 1.645
"""Size of noise over sigma that a tenth of it exceeds."""
