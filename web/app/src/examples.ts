// Programs to begin with: three parts of the repository, and a text.

import circle from "../../../parts/circle.ngc?raw";
import pocket from "../../../parts/pocket.ngc?raw";
import star from "../../../parts/star.ngc?raw";
import text from "../examples/text.ngc?raw";

export const EXAMPLES: Record<string, { about: string; program: string }> = {
  star: { about: "Rounded star, 220 arcs", program: star },
  circle: { about: "Circle, 10 mm radius", program: circle },
  pocket: { about: "Pocket, with rapids in Z", program: pocket },
  text: { about: "Engraved text", program: text },
};
