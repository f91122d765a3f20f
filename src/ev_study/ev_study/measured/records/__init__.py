"""Records of real cars: CSV files, bags of any messages and logs of CAN buses, and what their columns mean."""
