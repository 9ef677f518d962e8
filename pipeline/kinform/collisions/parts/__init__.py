"""What is asked of one part: surfaces that a motion maps onto themselves, borders, models."""
