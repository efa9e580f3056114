"""Controllers that learn, and networks inside the loop; a started law remembers what it learnt."""
