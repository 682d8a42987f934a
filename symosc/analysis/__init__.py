"""What is built on motions and their derivatives: fits to measurements, frequency responses."""
