"""What the top event owes to quantities that are not known for certain: its distribution, sensitivities, targets."""
