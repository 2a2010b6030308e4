"""What `import winch_friction as wf` gives: a few functions over the layers below, SI, each with a tested example."""
