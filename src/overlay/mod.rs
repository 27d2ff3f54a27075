//! What is shown: heat maps, diagrams, the report page, result.json, and what is added to a drawing.
