"""What is built on motions: derivatives, fits to measurements, frequency responses."""
