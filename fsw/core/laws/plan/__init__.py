"""What the laws that plan compute with: Riccati equations, costs, the orbit ahead, the pulses."""
