"""The panels beside the scene, one file a panel."""
