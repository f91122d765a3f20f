"""Tatar & Chudzik: three layouts of drives, and torques corrected by the steering angle."""
