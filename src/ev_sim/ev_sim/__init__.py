"""The world around the control laws: plant, steering column, driver, recorder, scenario runner."""
