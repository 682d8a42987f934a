"""The parts of a fit: measured data, residuals, the search for a minimum, errors, and a verdict."""
