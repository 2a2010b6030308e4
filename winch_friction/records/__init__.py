"""Files in and out: models, cranes, runs (rosbag2, CSV, Parquet) and checkpoints."""
