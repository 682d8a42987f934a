"""What every package uses: errors, types, exact numbers, quantities, files, arguments, display."""
