"""What turns road wheels where no column or rod does."""
