"""What a model may lack: every effect of the catalogue as one declaration that yields its regressors."""
