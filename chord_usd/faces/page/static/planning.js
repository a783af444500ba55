// What a home misses of published planning numbers, in words. Draws nothing.

const UNITS = {
  m: (finding) => [finding.have_m, finding.need_m].map((value) => (value === null ? "endless" : `${Math.round(value * 100)} cm`)),
  deg: (finding) => [finding.have, finding.need].map((value) => `${Math.round(value)}°`),
  count: (finding) => [finding.have, finding.need].map(String),
  share: (finding) => [finding.have, finding.need].map((value) => `${Math.round(value * 100)} %`),
};

const nameOf = (room) => room.path.split("/").pop() || "The home";

/** The rules that a design (`check --json`, "design") does not keep: {text, paths of prims}, the room with most of them first. */
export function findingsOf(design) {
  const places = [...(design?.rooms ?? []), ...(design?.home ? [design.home] : [])];
  places.sort((a, b) => b.rules - b.rules_kept - (a.rules - a.rules_kept));
  return places.flatMap((room) => room.findings.map((finding) => {
    const [have, need] = UNITS[finding.unit](finding);
    return {
      text: `${nameOf(room)}, ${finding.rule}: ${have}, not ${need} (${finding.source})`,
      paths: finding.items.length ? finding.items : room.path ? [room.path] : [],
    };
  }));
}
