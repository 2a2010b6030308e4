"""Effects that block means of the torque balance cannot show: each looks for one thing in its own way."""
