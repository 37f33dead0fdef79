"""Forms in which fault trees, dynamic trees and studies are written: Open-PSA MEF, Aralia text, Galileo, JSON, DOT."""
