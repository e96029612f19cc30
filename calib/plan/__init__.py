"""Which runs and measurements make the answer sharper, before anybody drives them."""
