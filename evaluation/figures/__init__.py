"""The paper's figures, drawn from our recordings and motions."""
