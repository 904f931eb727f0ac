// Numbers as the page shows them: millimetres and micrometres, or inches and thousandths.

export type Units = "mm" | "in";

export const INCH_MM = 25.4;

let units: Units = "mm";
export const setUnits = (now: Units) => { units = now; };
export const getUnits = () => units;

export const errorUnit = () => (units === "mm" ? "µm" : "thou");
export const lengthUnit = () => units;

/** An error in the unit of the page. */
export const error = (um: number) => (units === "mm" ? um : um / INCH_MM);

/** An error with the digits of the command; in thousandths of an inch one more, which is as fine. */
export function errorText(um: string | number): string {
  const value = Number(um);
  if (um === "-" || !Number.isFinite(value)) return "–";
  if (units === "in") return (value / INCH_MM).toFixed(3);
  return typeof um === "string" ? um : um.toFixed(2);
}

export function lengthText(mm: number): string {
  const value = units === "mm" ? mm : mm / INCH_MM, text = value.toFixed(units === "mm" ? 3 : 4);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

/** A round length without zeros at its end. */
export const roundLength = (mm: number) => `${Number((units === "mm" ? mm : mm / INCH_MM).toPrecision(3))} ${units}`;

export const roundBytes = (bytes: number) => `${Number((bytes / 1e6).toPrecision(3))} MB`;
