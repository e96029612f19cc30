"""Data and equations of the car: vehicle file, brakes, tyres, forces, physical effects, priors."""
